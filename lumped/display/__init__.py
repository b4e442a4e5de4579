"""What people see of results and of long work: numbers as text, tables of results, progress bars."""
