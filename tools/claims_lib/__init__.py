"""Rows of evidence behind what Treacle claims; run by tools/claims."""
