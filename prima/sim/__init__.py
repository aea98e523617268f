"""Headless simulation in virtual time: world, robot, person, services."""
