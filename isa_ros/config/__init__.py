"""From YAML files to checked, immutable configurations; the data that is shipped."""
