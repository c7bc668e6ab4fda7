"""A run: its ticks, its messages, its pace, its saved states."""
