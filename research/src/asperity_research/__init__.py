"""Research with Asperity: the paper's reproduction, studies of open questions, and reference problems."""
