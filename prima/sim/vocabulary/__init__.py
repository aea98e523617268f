"""The languages of worlds, scenarios and users, as tables."""
