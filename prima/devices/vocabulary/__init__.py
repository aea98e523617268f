"""The languages of robots and of services, as tables."""
