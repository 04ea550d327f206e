"""A page to explore: contacts that age, live, from a folder, or from one file."""
