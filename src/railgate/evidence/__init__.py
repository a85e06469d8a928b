"""What is shown of the functions: their claims, proven."""
