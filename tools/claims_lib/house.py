"""Rows of `house`: what the sources look like, and that putting them in order has changed no result."""

from . import house_documents, house_results, house_sources, house_tidy, house_tools
from .table import Table

TABLE = Table("house", built=False)

# The order is that of the table.
for rows in (house_results, house_sources, house_tidy, house_tools, house_documents):
    rows.add_rows(TABLE)
