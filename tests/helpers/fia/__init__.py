"""The Form Interpretation Algorithm once more, simply, and documents to try both on."""
