"""Accuracy of the plant's integration, against known solutions."""
