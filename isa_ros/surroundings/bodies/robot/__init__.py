"""A robot of rigid links, free or fixed, moved by any number of actuators."""
