"""What the commands say, as rows of words."""
