"""Both ends of the private wire (messages of the lockstep): coordinator and participants."""
