"""The folder of asperity-research; so that its tests have names of their own."""
