"""What people look at: figures, field pictures and the HTML page. Heavy imports stay in here."""
