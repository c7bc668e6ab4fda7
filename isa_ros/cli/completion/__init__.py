"""Completion of `isa` in bash, zsh and fish: scripts made of the parsers of its commands."""
