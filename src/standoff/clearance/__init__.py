"""Reports on the clearance of a scene's bodies: verdicts, fits that are meant, tables, pictures."""
