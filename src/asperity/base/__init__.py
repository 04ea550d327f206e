"""What every other room needs: checks of input, units, tables, words, views, the machine, the version."""
