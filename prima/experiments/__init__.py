"""Many runs: batches of scenarios, and studies of situations under every policy."""
