"""What can be asked of the engine: surfaces, solids, loads, times, quantities, as checked data."""
