"""Transcripts: records, reading and writing, the table that people read, and diff."""
