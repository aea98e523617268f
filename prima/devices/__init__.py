"""The parts common to all robots, simulated or real: device protocol, ear, senses, speech, loop.

All of it is sans-IO: given the time and what happens, it returns what is to be done and
what is to be reported. Nothing here has a clock, a thread or a file.
"""
