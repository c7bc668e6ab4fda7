"""YAML files to checked, immutable configurations; the data shipped with the package."""
