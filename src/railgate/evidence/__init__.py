"""What is shown of the functions: their claims, proven, and each requirement's evidence."""
