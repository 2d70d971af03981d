"""Pictures of frames, maps and distances; films."""
