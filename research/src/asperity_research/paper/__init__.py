"""The paper that Asperity starts from, reproduced: its simulations, its figures, its claims, one report."""
