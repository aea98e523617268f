"""VoiceXML 2.0 and 2.1 documents as applications (W3C Recommendations of 2004 and 2007)."""
