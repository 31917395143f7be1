"""Former name of the module drumlin.fem.equilibrium.group; old imports work, with a warning."""

from drumlin.base.moved import make_getattr_function_of_moved_module

NEW_NAMES_OF_GROUP_FUNCTIONS = {
    "groups_of": "divide_pressed_shoes_into_groups",
    "grouped": "divide_shoes_into_groups",
    "pressed_shoes": "indices_of_pressed_shoes_in_brake",
    "pressed": "is_shoe_pressed_on_drum",
}
"""The present name of each renamed function, by its old name."""

__getattr__ = make_getattr_function_of_moved_module(
    __name__, "drumlin.fem.equilibrium.group", NEW_NAMES_OF_GROUP_FUNCTIONS
)
