"""Transcripts: records, reading and writing, the printed table, and diff."""
