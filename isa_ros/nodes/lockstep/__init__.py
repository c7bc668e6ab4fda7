"""Both ends of the private wire between a coordinator and its participants."""
