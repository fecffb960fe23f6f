"""Many jobs: planned from what a command names, run in worker processes or on a cluster, skipped where up to date."""
