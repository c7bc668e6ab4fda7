"""How exactly the plant is integrated, against solutions that are known."""
