"""Files on disk: written whole, opened within limits, and the formats that several packages read."""
