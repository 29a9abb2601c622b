"""Scans: any question over many tubes, on all cores or a cluster, each finished case kept whatever happens."""
