"""A sweep's table as one page: distributions, intervals, tests and a map of orders."""
