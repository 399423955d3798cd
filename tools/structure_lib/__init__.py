"""What tools/check_structure and tools/claims read in the tree: comments, tags, names, declarations, functions, places, loops."""
