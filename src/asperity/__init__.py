"""Asperity: how the real contact between rough solids grows old."""
