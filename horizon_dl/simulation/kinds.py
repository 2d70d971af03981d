"""Names of the kinds of world, in a module that imports nothing."""

KINDS = {
    "arena": "a flight among boxes, panels and poles",
    "clutter": "a room full of desks, chairs, shelves, boxes and steps",
    "hallway": "a long hallway with doors, cabinets, chairs and trolleys at its walls, and a shining floor",
    "office": "a crowded office with desks, screens, swivel chairs and what lies about",
    "outdoor": "a yard with grass or paving, cars, trees and shadows",
    "street": "a street between houses with parked cars, trees, people and shadows",
}
