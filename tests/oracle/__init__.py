"""Independent models that the package is measured against."""
