"""A page to explore: contacts that age, live from a process that computes, from a folder, or from one file."""
