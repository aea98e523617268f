"""Attributes that documents of all kinds have."""

VERSION = "version*: text(1.0) | the language's version"
ID = "id*: id | its name"
TITLE = "title: text | what people call it"
