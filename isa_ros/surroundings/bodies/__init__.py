"""The kinds of bodies, a folder or a file each."""
