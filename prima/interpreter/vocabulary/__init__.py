"""The dialogue language: its elements as one table.

Words that VoiceXML has mean what they mean there; Commands are the rows of the
thesis's Table 4.2, ``iu`` is its Information Unit, ``seq`` and ``par`` are
SMIL's.
"""
