"""What is told of documents before they run: warnings that are left out, and certificates."""
