"""Install the peers: ``python -m bench.peers``."""

from bench.peers import main

main()
