"""Names of the kinds of world, in a module that imports nothing."""

KINDS = {
    "arena": "a flight among boxes, panels and poles",
    "clutter": "a room full of desks, chairs, shelves, boxes and steps",
    "outdoor": "a yard with grass or paving, cars, trees and shadows",
}
