"""The fast family: modes coupled by one periodic feedback of rank one."""
