"""Steady sliding over a viscoelastic solid: friction and contact area against speed."""
