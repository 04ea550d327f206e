"""Tables of numbers in text files: their rows, and their columns by role."""
