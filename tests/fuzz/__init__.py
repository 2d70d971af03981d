"""Damaged and hostile inputs for everything that is read: nothing but the documented errors, in bounds."""
