"""Files on disk: atomic writing, reading with size limits, and the formats that several packages share."""
