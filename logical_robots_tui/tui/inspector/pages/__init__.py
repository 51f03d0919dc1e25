"""The pages of the inspector, one file each."""
