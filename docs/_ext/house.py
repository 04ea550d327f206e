"""The rooms of the source and who imports whom, drawn."""


def drawing():
    return "<svg xmlns='http://www.w3.org/2000/svg'/>"
