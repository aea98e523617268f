"""What every robot has, simulated or real: the protocol of devices, ear, senses, speech, the loop.

All of it is sans-IO: told of the time and of what happens, it says what is to be done and
what is to be reported. Nothing here has a clock, a thread or a file.
"""
