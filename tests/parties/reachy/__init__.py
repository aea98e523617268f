"""The driver of Reachy Mini against its maker's daemon, which moves the robot in MuJoCo."""
