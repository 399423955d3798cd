"""Tables and figures of the dissertation; one module for each group of them."""
