"""Parts that scenes of several tables share."""


def open_domain(dimensions, low, high, spacing, gravity):
    """The `domain` block of a scene whose sides are all open; low, high, gravity: lists of as many numbers."""
    sides = ", ".join(f"{axis}_{side}: open" for axis in "xyz"[:dimensions] for side in ("min", "max"))
    return f"""domain:
  dimensions: {dimensions}
  min: {low}
  max: {high}
  spacing: {spacing}
  gravity: {gravity}
  boundaries: {{{sides}}}"""
